"""Where the network comes from: data, rendering, network, loss, training, evaluation, export."""
