"""The navigation errors of a strapdown system and its measurement residuals."""
