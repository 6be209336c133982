"""The paper's error model of six factors: the model, its modified particle swarm, least squares, intervals."""
