"""Polish: bending and creases at their least energy, subject to K, by mid-edge normals on the user's mesh."""
