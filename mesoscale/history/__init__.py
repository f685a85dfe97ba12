"""What repeated closing and time under load do to a contact (docs/history.md)."""
