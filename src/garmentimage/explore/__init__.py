"""Exploring garments in the latent space of a trained network. Needs no torch."""
