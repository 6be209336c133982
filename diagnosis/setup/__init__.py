"""The set-up of a recording, checked before its physics: magnet, poles, senses, units, clocks, frames, tables."""
