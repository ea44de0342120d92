"""Job database: jobs, their records and events, accounts, and the queue that workers take units from."""
