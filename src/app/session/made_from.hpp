// Which result a prediction was made from, what its checks say, and whether that is still the one that lies beside it.
#pragma once
#include <filesystem>
#include <optional>

#include "app/session/session.hpp"
#include "result/finding.hpp"
#include "result/report.hpp"

namespace sysid {

/// For the versions of a predict task's report: the task whose draws it takes, and the digest of that one's summary.json. Nothing
/// of other tasks.
Facts made_from(Session const& session, Task const& task);

/// `made_from_earlier` where the result beside `folder` that it was made from has changed since. Nothing where it is gone: then
/// there is no other to be taken for it.
std::optional<Finding> made_from_earlier(std::filesystem::path const& folder);

/// `from_doubtful_fit`: an error where the fit whose results are in that folder has failed its checks or is unfinished, a warning
/// where it is to be used with care.
void add_source(std::filesystem::path const& fit, Report& report);

}  // namespace sysid
