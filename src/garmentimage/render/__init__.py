"""Pictures of patterns and GarmentImages, flat on paper."""
