"""The raster: GarmentImage, its files, and the way from a pattern to it and back."""

from garmentimage.raster.frame import BodyFrame
from garmentimage.raster.image import EdgeType, GarmentImage, PanelMark

__all__ = ["BodyFrame", "EdgeType", "GarmentImage", "PanelMark"]
