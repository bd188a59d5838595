"""Where the ground will lie in sun: shade maps in, probabilities by lead out."""
