// name_table.h - numbers by name, found in constant time however many there are.

#ifndef LS_NAME_TABLE_H
#define LS_NAME_TABLE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C"
{
#endif

    typedef struct LsNamedNumber
    {
        char* name; // owned
        uint32_t number;
    } LsNamedNumber;

    // Zero it before use; ls_name_table_destroy frees it.
    typedef struct LsNameTable
    {
        LsNamedNumber* entries; // in the order of their first mention
        uint32_t count;
        uint32_t* slots; // hash table of indices into `entries` plus 1; 0: free
        uint32_t slot_count;
    } LsNameTable;

    // The entry of a name, or NULL; valid until the next is set.
    LsNamedNumber* ls_name_table_find(const LsNameTable* table, const char* name);

    // Sets the number of a name, old or new; false when out of memory.
    bool ls_name_table_set(LsNameTable* table, const char* name, uint32_t number);
    void ls_name_table_destroy(LsNameTable* table);

#ifdef __cplusplus
}
#endif

#endif
