"""What operators of a server need: readiness, metrics, logs, configuration, and backup of the store."""
