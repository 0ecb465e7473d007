"""Datasets: recipes of what to make, and the rows that come of them."""
