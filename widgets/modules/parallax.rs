widgets::module!(widgets::parallax::Parallax);
