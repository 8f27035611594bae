widgets::module!(widgets::marginalization::Marginalization);
