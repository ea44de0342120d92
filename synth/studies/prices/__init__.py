"""What each limit costs."""
