"""Curves, polygons and quad meshes. No garment words in here."""
