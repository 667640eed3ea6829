"""How much memory a run will take, and how much there is."""
