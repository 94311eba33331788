// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "import.hpp"
#include "page_table.hpp"
#include "page_text.hpp"

namespace petzval::formats_detail {

/// The aspheric data of a printed page: blocks ("Surface 2", "K = 0.5 A4 = 1.2E-05"), a row per surface below a head
/// (K A4 A6), or a row per term below the numbers of the surfaces.
class PageAspheres {
 public:
  /// @param page all lines of the page; its formula tells the orders of terms A, B, C, and if K of a sphere is 1
  PageAspheres(std::span<const PageLine> page, Import& in);

  /// Takes a line of aspheric data; false for other lines.
  /// @param titled true below the title of aspheric data, where single letters are terms
  bool take(const PageLine& line, bool titled);
  /// Puts conics and terms into the surfaces of the lens, one per row of the table.
  /// @throws Error for a surface that the table lacks, and for a marked asphere without data
  /// @param several  true if the data may stand behind another table
  void apply(const PageTable& table, bool several);

 private:
  /// A column or a name: the conic, or a term.
  struct Key {
    std::string name;
    std::optional<int> order;  ///< nullopt for the conic
    char letter = '\0';        ///< of a term with a letter and no order
    int of_sphere = 0;         ///< usual number of a sphere for the name of a conic: 1 for kappa
    bool is_radius = false;
  };
  struct Value {
    Key key;
    int line = 0;
    double number = 0;
  };

  std::optional<Key> key_of(std::string_view word) const;
  std::vector<Key> keys_of(const PageLine& line, std::size_t from, bool titled) const;
  std::size_t name_surfaces(const PageLine& whole);
  bool take_row(const PageLine& line);
  void take_formula(std::string_view text);
  bool may_follow(const Key& key) const;
  [[noreturn]] void refuse_row() const;
  bool take_values(const PageLine& line, std::size_t from, bool titled);
  void put(int surface, const Key& key, const PageLine& line, const PageToken& value);
  int order_of(const Value& value) const;
  int number_of_sphere(const Key& key) const;

  Import& in_;
  std::map<int, std::vector<Value>> values_;  ///< by the label of the surface
  std::vector<int> surfaces_;                 ///< of the block
  std::vector<Key> columns_;                  ///< of the head
  std::vector<PageToken> row_;                ///< values of a row that the next line continues
  int row_line_ = 0, head_line_ = 0;
  std::map<int, int> orders_;      ///< from the formula of the page, by the number of the term
  std::optional<int> order_of_a_;  ///< from the formula of the page
  bool k_of_sphere_is_0_ = false, k_of_sphere_is_1_ = false;
};

}  // namespace petzval::formats_detail
