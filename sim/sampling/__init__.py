"""Low-discrepancy and counter-based random numbers, and the shapes drawn from them."""

__all__: list[str] = []
