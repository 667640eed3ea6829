"""How accurate a result is: references without photons, and the measures that compare with them."""

__all__: list[str] = []
