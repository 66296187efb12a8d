// The file that reproduces a task: models and data as written, the task with every setting spelt out.
#pragma once
#include "app/session/session.hpp"

namespace sysid {

std::string resolved_fit(Session const& session, Task const& task, FitTask const& what, Settings const& settings,
                         SolverSettings const& solver, std::uint64_t seed);

std::string resolved_select(Session const& session, Task const& task, SelectTask const& what, std::uint64_t seed);

/// "spike_slab, derivatives = weak"; in discrete time the selector alone.
std::string method_text(CheckedDictionary const& dictionary, DiscoverTask const& what);
std::string resolved_discover(Session const& session, Task const& task, DiscoverTask const& what, std::uint64_t seed);

/// That text as files that run in the folder of the results: data are named from there, and modules that lie beside the user's file
/// are written as resolved_NAME.sysid. By name, with their text; resolved.sysid first.
std::vector<std::pair<std::string, std::string>> resolved_files(Session const& session, Task const& task,
                                                                std::string const& resolved);

/// "mh(samples = 25000, ...)", every setting in the order of the table.
std::string settings_text(std::string const& backend, Settings const& settings);

/// "near(posterior)"; empty where the search has no such beginning.
std::string search_text(CheckedFile const& file, FitTask const& fit);

}  // namespace sysid
