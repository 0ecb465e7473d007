"""Two patterns compared: panels, stitch graphs, faults; whether one is the same as the other."""
