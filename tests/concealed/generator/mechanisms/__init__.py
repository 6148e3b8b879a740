"""The mechanisms, by where they act; `listed` are known to catalogues, `unlisted` to none."""
