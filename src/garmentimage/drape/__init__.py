"""Cloth on a body: panel meshes sewn together, put round the body, and simulated until at rest."""
