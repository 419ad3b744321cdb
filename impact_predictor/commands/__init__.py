"""The commands of `impact-predictor`, thin over the library; what is heavy is imported when one runs."""
