// One configuration mechanism. A component has one plain struct with defaults and one function
//
//   void Fields(FieldList& f) { f.Add("repose_deg", repose_deg, "angle of repose [deg]", 5, 60); }
//
// and that list drives YAML files, dotted overrides, ranges, --help, and the resolved copy that
// every result carries. Unknown keys and values out of range are errors that name the key.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace sandwright {

struct Field {
  using Target = std::variant<bool*, int64_t*, double*, std::string*, std::vector<double>*,
                              std::vector<std::string>*>;
  std::string key;                                        // dotted: "ppo.clip_range"
  Target target;                                          // where the value lives
  std::string help;                                       // meaning, with the unit in brackets
  double low = -std::numeric_limits<double>::infinity();  // inclusive, numbers only
  double high = std::numeric_limits<double>::infinity();
  std::vector<std::string> choices;  // texts only; empty: any
};

// Points into the structs that were added; they must outlive it.
class FieldList {
 public:
  template <class T>
  void Add(const std::string& key, T& value, std::string help,
           double low = -std::numeric_limits<double>::infinity(),
           double high = std::numeric_limits<double>::infinity()) {
    fields_.push_back({prefix_ + key, &value, std::move(help), low, high, {}});
  }
  void Add(const std::string& key, std::string& value, std::string help,
           std::vector<std::string> choices = {}) {
    const double infinity = std::numeric_limits<double>::infinity();
    fields_.push_back(
        {prefix_ + key, &value, std::move(help), -infinity, infinity, std::move(choices)});
  }
  // The fields of a component under "name.".
  template <class Component>
  void Section(const std::string& name, Component& component) {
    const std::string outer = prefix_;
    prefix_ += name + ".";
    component.Fields(*this);
    prefix_ = outer;
  }

  const std::vector<Field>& fields() const { return fields_; }

 private:
  std::string prefix_;
  std::vector<Field> fields_;
};

template <class Component>
FieldList FieldsOf(Component& component) {
  FieldList list;
  component.Fields(list);
  return list;
}

// Each throws Error naming the key (and file), the value and what is allowed; an unknown key
// suggests the nearest one. On error nothing has been changed.
void LoadYaml(const FieldList& fields, const std::filesystem::path& file);
void ApplyOverrides(const FieldList& fields, std::span<const std::string> key_equals_value);
void LoadJson(const FieldList& fields, const nlohmann::json& nested, const std::string& source);
void SetField(const FieldList& fields, const std::string& key, const std::string& value);

// The resolved configuration, nested by section.
nlohmann::json ToJson(const FieldList& fields);
std::string ToYaml(const FieldList& fields);  // each key with its help as a comment
std::string Help(const FieldList& fields);    // one line a key: default, range, meaning

// The candidate nearest to `word` by edit distance, or "" where none is near.
std::string NearestName(const std::string& word, std::span<const std::string> candidates);

}  // namespace sandwright
