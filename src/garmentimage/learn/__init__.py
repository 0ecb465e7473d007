"""Networks on GarmentImages and on vectors, and their training. Needs torch."""
