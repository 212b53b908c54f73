"""EMCO Concept Mill 250: the programs that its control reads, the links to it, and a control that is simulated."""
