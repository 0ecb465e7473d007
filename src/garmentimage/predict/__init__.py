"""A picture in, a pattern out: the cascade of Section 4.3 in use. No torch."""
