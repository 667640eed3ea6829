"""Charts of what spectra are made of: media, metals, light, and their colours."""
