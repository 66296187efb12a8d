// Where the numbers of a result come from.
#pragma once
#include "app/session/session.hpp"
#include "experiment/experiments.hpp"
#include "result/report.hpp"

namespace sysid {

/// SHA-256 of the measured samples that a likelihood reads: channels by name, each sample with its row, in the channel's declared
/// unit. Equal digests mean densities of the same numbers, which alone can be compared.
std::string samples_digest(Experiment const& experiment, Model const& model);

/// Whether a finding is one of the numbers of a record, whichever task reads it.
bool tells_of_data(FindingCode code);

/// Adds what the numbers that a model reads give to think, unless it is there.
void look_at_data(CheckedFile const& file, ExperimentData const& data, Model const& model, Findings& findings);

/// The same of all experiments that one likelihood reads, and samples that count twice (`find_pasted_rows`,
/// `find_repeated_samples`).
void look_at_all_data(CheckedFile const& file, std::vector<ExperimentData> const& data, Model const& model, Findings& findings);

/// `add_data` of all experiments that one likelihood reads, and what they have in common.
void add_fitted_data(CheckedFile const& file, std::vector<ExperimentData> const& data, Model const& model, Report& report);

/// Adds file, digest, rows and columns of one experiment to the report, and what its numbers give to think (`look_at_data`).
void add_data(CheckedFile const& file, ExperimentData const& data, Model const& model, Report& report);

/// Prints findings, but not notes, as notices before the part of a task that takes time.
void print_findings(Session& session, Task const& task, Findings const& findings);
/// Of the numbers of a task's records.
void print_data_findings(Session& session, Task const& task, std::vector<ExperimentData> const& data, Model const& model);

}  // namespace sysid
