#include "data/base/config.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {

using Value =
    std::variant<bool, int64_t, double, std::string, std::vector<double>, std::vector<std::string>>;

// A value that was parsed and checked but not yet stored.
struct Assignment {
  const Field* field;
  Value value;
};

const Field& Find(const FieldList& list, const std::string& key, const std::string& source) {
  std::vector<std::string> keys;
  for (const Field& field : list.fields()) {
    if (field.key == key) return field;
    keys.push_back(field.key);
  }
  const std::string nearest = NearestName(key, keys);
  throw Error(fmt::format("{}: unknown key '{}'{}", source, key,
                          nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

std::string Range(const Field& field) {
  const bool low = std::isfinite(field.low), high = std::isfinite(field.high);
  if (low && high) return fmt::format("{:g}..{:g}", field.low, field.high);
  if (low) return fmt::format(">= {:g}", field.low);
  if (high) return fmt::format("<= {:g}", field.high);
  return "";
}

[[noreturn]] void Reject(const std::string& source, const Field& field, const std::string& value,
                         const std::string& allowed) {
  throw Error(fmt::format("{}: {} = {} is not allowed; {}", source, field.key, value, allowed));
}

void CheckRange(const std::string& source, const Field& field, double value) {
  if (!std::isfinite(value) || value < field.low || value > field.high)
    Reject(source, field, fmt::format("{:g}", value),
           Range(field).empty() ? "a finite number" : "allowed: " + Range(field));
}

template <class T>
T Parse(const std::string& source, const Field& field, const YAML::Node& node, const char* kind) {
  try {
    return node.as<T>();
  } catch (const YAML::Exception&) {
    YAML::Emitter text;
    text << YAML::Flow << node;
    Reject(source, field, text.c_str(), std::string("expected ") + kind);
  }
}

Assignment ParseField(const std::string& source, const Field& field, const YAML::Node& node) {
  struct Visitor {
    const std::string& source;
    const Field& field;
    const YAML::Node& node;
    Value operator()(bool*) { return Parse<bool>(source, field, node, "true or false"); }
    Value operator()(int64_t*) {
      const auto value = Parse<int64_t>(source, field, node, "a whole number");
      CheckRange(source, field, static_cast<double>(value));
      return value;
    }
    Value operator()(double*) {
      const auto value = Parse<double>(source, field, node, "a number");
      CheckRange(source, field, value);
      return value;
    }
    Value operator()(std::string*) {
      const auto value = Parse<std::string>(source, field, node, "a text");
      if (!field.choices.empty() && std::ranges::find(field.choices, value) == field.choices.end())
        Reject(source, field, value,
               "allowed: " + fmt::format("{}", fmt::join(field.choices, ", ")));
      return value;
    }
    Value operator()(std::vector<double>*) {
      const auto values = Parse<std::vector<double>>(source, field, node, "a list of numbers");
      for (double value : values) CheckRange(source, field, value);
      return values;
    }
    Value operator()(std::vector<std::string>*) {
      return Parse<std::vector<std::string>>(source, field, node, "a list of texts");
    }
  };
  return {&field, std::visit(Visitor{source, field, node}, field.target)};
}

void Collect(const FieldList& list, const std::string& source, const YAML::Node& node,
             const std::string& prefix, std::vector<Assignment>& out) {
  if (!node.IsMap())
    throw Error(
        fmt::format("{}: '{}' must be a map of keys", source, prefix.empty() ? "/" : prefix));
  for (const auto& entry : node) {
    if (!entry.first.IsScalar()) throw Error(source + ": a key must be a word, not a list or map");
    const std::string key = prefix + entry.first.Scalar();
    const bool is_field = std::ranges::any_of(list.fields(), [&](auto& f) { return f.key == key; });
    if (!is_field && entry.second.IsMap()) {
      Collect(list, source, entry.second, key + ".", out);
    } else {
      out.push_back(ParseField(source, Find(list, key, source), entry.second));
    }
  }
}

void Store(const std::vector<Assignment>& assignments) {
  for (const Assignment& a : assignments) {
    std::visit([&]<class T>(T* target) { *target = std::get<T>(a.value); }, a.field->target);
  }
}

nlohmann::json FieldToJson(const Field& field) {
  return std::visit([](auto* value) { return nlohmann::json(*value); }, field.target);
}

std::string FieldText(const Field& field) {
  const nlohmann::json value = FieldToJson(field);
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  return value.dump();  // JSON values are YAML flow values
}

}  // namespace

void LoadYaml(const FieldList& fields, const std::filesystem::path& file) {
  YAML::Node root;
  try {
    root = YAML::LoadFile(file.string());
  } catch (const YAML::BadFile&) {
    throw Error("cannot read configuration " + file.string() + ": no such file");
  } catch (const YAML::Exception& e) {
    throw Error(fmt::format("{}: not YAML: {}", file.string(), e.what()));
  }
  if (root.IsNull()) return;
  std::vector<Assignment> assignments;
  Collect(fields, file.string(), root, "", assignments);
  Store(assignments);
}

void SetField(const FieldList& fields, const std::string& key, const std::string& value) {
  ApplyOverrides(fields, std::vector<std::string>{key + "=" + value});
}

void ApplyOverrides(const FieldList& fields, std::span<const std::string> overrides) {
  std::vector<Assignment> assignments;
  for (const std::string& text : overrides) {
    const size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw Error("override '" + text + "' is not of the form key=value");
    const Field& field = Find(fields, text.substr(0, equals), "override");
    YAML::Node node;
    try {
      node = YAML::Load(text.substr(equals + 1));
    } catch (const YAML::Exception& e) {
      throw Error(fmt::format("override '{}': {}", text, e.what()));
    }
    assignments.push_back(ParseField("override", field, node));
  }
  Store(assignments);
}

void LoadJson(const FieldList& fields, const nlohmann::json& nested, const std::string& source) {
  std::vector<Assignment> assignments;
  Collect(fields, source, YAML::Load(nested.dump()), "", assignments);
  Store(assignments);
}

nlohmann::json ToJson(const FieldList& fields) {
  nlohmann::json root = nlohmann::json::object();
  for (const Field& field : fields.fields()) {
    std::string pointer = "/" + field.key;
    std::ranges::replace(pointer, '.', '/');
    root[nlohmann::json::json_pointer(pointer)] = FieldToJson(field);
  }
  return root;
}

std::string ToYaml(const FieldList& list) {
  std::string text;
  std::vector<std::string> open;  // sections already printed
  for (const Field& field : list.fields()) {
    std::vector<std::string> parts;
    for (size_t start = 0;;) {
      const size_t dot = field.key.find('.', start);
      parts.push_back(field.key.substr(start, dot - start));
      if (dot == std::string::npos) break;
      start = dot + 1;
    }
    const size_t depth = parts.size() - 1;
    size_t same = 0;
    while (same < depth && same < open.size() && open[same] == parts[same]) ++same;
    open.resize(same);
    for (; same < depth; ++same) {
      text += std::string(2 * same, ' ') + parts[same] + ":\n";
      open.push_back(parts[same]);
    }
    text += fmt::format("{}{}: {}  # {}\n", std::string(2 * depth, ' '), parts.back(),
                        FieldText(field), field.help);
  }
  return text;
}

std::string Help(const FieldList& list) {
  std::string text;
  for (const Field& field : list.fields()) {
    std::string allowed = Range(field);
    if (!field.choices.empty()) allowed = fmt::format("{}", fmt::join(field.choices, " | "));
    text += fmt::format("  {:<32} {}  (default {}{})\n", field.key, field.help, FieldText(field),
                        allowed.empty() ? "" : ", " + allowed);
  }
  return text;
}

std::string NearestName(const std::string& word, std::span<const std::string> candidates) {
  std::string best;
  size_t best_distance = std::max<size_t>(3, word.size() / 2);
  for (const std::string& candidate : candidates) {
    std::vector<size_t> row(candidate.size() + 1);  // Levenshtein, one row
    for (size_t j = 0; j < row.size(); ++j) row[j] = j;
    for (size_t i = 1; i <= word.size(); ++i) {
      size_t diagonal = row[0];
      row[0] = i;
      for (size_t j = 1; j < row.size(); ++j) {
        const size_t substitute = diagonal + (word[i - 1] != candidate[j - 1]);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
      }
    }
    if (row.back() < best_distance) best_distance = row.back(), best = candidate;
  }
  return best;
}

}  // namespace sandwright
