"""Device functions for where a ray meets a shape, one shape a file."""

__all__: list[str] = []
