//! The binary protocol between the Recon station and its companion apps.
