"""Patterns made from measurements, designs and templates."""
