"""Editing garments by text: guidance by diffusion models, and what a latent vector becomes."""
