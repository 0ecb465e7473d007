"""Bodies that garments are drafted for and put on: meshes, and the measurements taken off them."""
