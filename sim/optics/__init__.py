"""Device functions for what a surface does to light."""

__all__: list[str] = []
