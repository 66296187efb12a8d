// Changes are drawn uniformly over kinds and places.
#include "fuzz/mutator.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

namespace sysid::fuzz {
namespace {

using json = nlohmann::json;

/// All values below `value`, itself included.
void collect(json& value, std::vector<json*>& all) {
  all.push_back(&value);
  if (value.is_structured())
    for (json& each : value) collect(each, all);
}

json other_value(std::uint64_t choice) {
  switch (choice) {
    case 0:
      return nullptr;
    case 1:
      return -1;
    case 2:
      return std::numeric_limits<std::uint64_t>::max();
    case 3:
      return std::uint64_t{1} << 40;
    case 4:
      return "other";
    case 5:
      return json::array();
    case 6:
      return json::object();
    case 7:
      return json::binary({});
    case 8:
      return json::binary(std::vector<std::uint8_t>(8, 0x7f));
    case 9:
      return std::numeric_limits<double>::quiet_NaN();
    case 10:
      return true;
    default:
      return 3;
  }
}

}  // namespace

std::string Mutator::operator()(std::string bytes) {
  for (std::uint64_t changes = 1 + below(3); changes > 0; --changes) change(bytes);
  return bytes;
}

json Mutator::operator()(json value) {
  std::vector<json*> all;
  collect(value, all);
  json& at = *all[below(all.size())];
  switch (below(4)) {
    case 0:
      at = other_value(below(12));
      break;
    case 1: {
      json const other = *all[below(all.size())];
      at = other;
      break;
    }
    case 2:
      if (!at.is_structured() || at.empty())
        at = other_value(below(12));
      else if (auto const part = std::next(at.begin(), static_cast<std::ptrdiff_t>(below(at.size()))); below(2) == 0)
        at.erase(part);
      else if (at.is_array())
        at.push_back(json(*part));
      break;
    default:
      if (at.is_binary()) {
        json::binary_t& bytes = at.get_binary();
        std::string const changed = (*this)(std::string(bytes.begin(), bytes.end()));
        bytes.assign(changed.begin(), changed.end());
      } else if (at.is_number_integer()) {
        at = at.get<std::int64_t>() + (below(2) == 0 ? 1 : -1);
      } else {
        at = other_value(below(12));
      }
  }
  return value;
}

void Mutator::change(std::string& bytes) {
  std::uint64_t const at = below(bytes.size()), length = below(std::min<std::uint64_t>(bytes.size() - at, 1 + below(200)) + 1);
  switch (below(8)) {
    case 0:
      if (!bytes.empty()) bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1U << below(8)));
      break;
    case 1:
      if (!bytes.empty()) bytes[at] = static_cast<char>(below(256));
      break;
    case 2:
      bytes.resize(at);
      break;
    case 3:
      bytes.erase(at, length);
      break;
    case 4:
      bytes.insert(below(bytes.size() + 1), bytes.substr(at, length));
      break;
    case 5:
      bytes.insert(at, 1 + below(3), static_cast<char>(below(256)));
      break;
    case 6: {  // another digit
      auto const digit = bytes.find_first_of("0123456789", at);
      if (digit != std::string::npos) bytes[digit] = static_cast<char>('0' + below(10));
      break;
    }
    default:  // deep nesting
      bytes.insert(at, 1 + below(5000), "\x81[{\x9f\x7f\xd8"[below(6)]);
      break;
  }
}

}  // namespace sysid::fuzz
