"""Physical causes set in hardware units, from the twin's description to the name that an answer gives."""
