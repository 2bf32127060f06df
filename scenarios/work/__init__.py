"""Work spread over processes, here or on other machines. Knows nothing of formations."""
