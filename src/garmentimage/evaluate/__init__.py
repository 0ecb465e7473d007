"""Measuring trained networks on held-out garments: the tables of the paper."""
