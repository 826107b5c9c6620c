// What Python needs of the C++ side, written once: drillpetsc/kernels/parameters.py reads the texts that these macros export.
//
//   DP_ENUM(Parameter, LENGTH, GRAVITY, OFFSET = GRAVITY + 3, NP)     an enum, its text in ParameterText; the last name is the count
//   DP_RECORD(Fluid, double density; const double* rheology;)         a struct of double, int and pointers, its text in FluidText
//   DP_EXPORT(symbol, text)                                           text of either, for Python's columns(symbol)
//   DP_EXPORT_RECORD(symbol, Record)                                  text and size of a struct, for Python's record(symbol)
//   DP_CONSTANT(symbol, value)                                        a number, for Python's constant(symbol)
//
// A column is as wide as the distance to the next one.  Comments between the names do not reach the text.
#pragma once

#define DP_ENUM(Name, ...) DP_ENUM_OF(Name, __VA_ARGS__)  // once more, so that a list may be a macro
#define DP_ENUM_OF(Name, ...)  \
    enum Name { __VA_ARGS__ }; \
    static constexpr const char* Name##Text = #__VA_ARGS__;

#define DP_RECORD(Name, ...)   \
    struct Name { __VA_ARGS__ }; \
    static constexpr const char* Name##Text = #__VA_ARGS__;

#define DP_EXPORT(symbol, text) \
    extern "C" const char* symbol##_columns() { return text; }

#define DP_EXPORT_RECORD(symbol, Record)                                 \
    extern "C" const char* symbol##_fields() { return Record##Text; }     \
    extern "C" int symbol##_size() { return static_cast<int>(sizeof(Record)); }

#define DP_CONSTANT(symbol, value) \
    extern "C" double symbol##_constant() { return value; }
