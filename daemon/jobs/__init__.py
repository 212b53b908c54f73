"""Every job is remembered, planned in a worker, and handed to the machine once."""
