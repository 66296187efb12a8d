# What the R package `posterior` says of draws in the form of Stan's CSV: a line of numbers for each variable, to the last digit.
suppressMessages(library(posterior))
folder <- commandArgs(TRUE)[1]
files <- sort(Sys.glob(file.path(folder, "draws_*.csv")))
chains <- lapply(files, function(file) as_draws_matrix(read.csv(file, comment.char = "#", check.names = FALSE)))
draws <- do.call(bind_draws, c(chains, along = "chain"))
summaries <- summarise_draws(draws, "mean", "median", "sd", "mad", "quantile2", "rhat", "ess_bulk", "ess_tail", "mcse_mean")
for (row in seq_len(nrow(summaries)))
  cat(summaries$variable[row], sprintf("%.17g", as.numeric(summaries[row, -1])), sep = "\t", fill = 10000)
