"""From photons to pictures: gathering, the film, and the files that hold it."""
