// name_table.c - numbers by name, found in constant time however many there are.

#include "name_table.h"

#include <stdlib.h>
#include <string.h>

// FNV-1a.
static uint32_t hash_name(const char* name)
{
    uint32_t hash = 2166136261u;
    for (; *name; name++)
        hash = (hash ^ (uint8_t)*name) * 16777619u;
    return hash;
}

// The slot that holds the name or that is free for it; there is a free one always.
static uint32_t* find_slot(const LsNameTable* table, const char* name)
{
    uint32_t at = hash_name(name) & (table->slot_count - 1);
    while (table->slots[at] && strcmp(table->entries[table->slots[at] - 1].name, name))
        at = (at + 1) & (table->slot_count - 1);
    return &table->slots[at];
}

LsNamedNumber* ls_name_table_find(const LsNameTable* table, const char* name)
{
    if (table->slot_count == 0)
        return NULL;
    const uint32_t slot = *find_slot(table, name);
    return slot ? &table->entries[slot - 1] : NULL;
}

// Twice the room, at most half of the slots in use.
static bool grow(LsNameTable* table)
{
    const uint32_t slot_count = table->slot_count ? 2 * table->slot_count : 32;
    if (slot_count <= table->slot_count)
        return false;
    LsNamedNumber* entries = realloc(table->entries, slot_count / 2 * sizeof *entries);
    if (!entries)
        return false;
    table->entries = entries;
    uint32_t* slots = calloc(slot_count, sizeof *slots);
    if (!slots)
        return false;
    free(table->slots);
    table->slots = slots;
    table->slot_count = slot_count;
    for (uint32_t i = 0; i < table->count; i++)
        *find_slot(table, table->entries[i].name) = i + 1;
    return true;
}

bool ls_name_table_set(LsNameTable* table, const char* name, uint32_t number)
{
    LsNamedNumber* known = ls_name_table_find(table, name);
    if (known)
    {
        known->number = number;
        return true;
    }
    if (table->count >= table->slot_count / 2 && !grow(table))
        return false;
    char* copy = strdup(name);
    if (!copy)
        return false;
    uint32_t* slot = find_slot(table, name);
    table->entries[table->count++] = (LsNamedNumber){copy, number};
    *slot = table->count;
    return true;
}

void ls_name_table_destroy(LsNameTable* table)
{
    for (uint32_t i = 0; i < table->count; i++)
        free(table->entries[i].name);
    free(table->entries);
    free(table->slots);
    *table = (LsNameTable){0};
}
