"""What a continuously self-imaging grating (CSIG) projects: orders, harmonics, the pattern."""
